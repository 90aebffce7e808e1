# Writes OUTPUT, a C++ file whose FUNCTION returns the text of all SOURCES one after the other.
set(text "")
foreach(source IN LISTS SOURCES)
  file(READ "${source}" content)
  string(APPEND text "R\"opencl(${content})opencl\"\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"kernels/embedded_sources.hpp\"\n\nnamespace verisq::kernels {\n\n"
                       "std::string_view ${FUNCTION}() {\n  return\n${text};\n}\n\n}  // namespace verisq::kernels\n")
