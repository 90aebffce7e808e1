# Writes OUTPUT, a C++ file whose FUNCTION returns the text of PAGE: as numbers, because compilers promise no string literals of its length.
file(READ "${PAGE}" bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE "${OUTPUT}" "#include \"report/page_template.hpp\"\n\nnamespace verisq::report {\nnamespace {\n\n"
                       "constexpr char page[] = {\n${bytes}};\n\n}  // namespace\n\n"
                       "std::string_view ${FUNCTION}() { return {page, sizeof page}; }\n\n"
                       "}  // namespace verisq::report\n")
