# What shared libraries export, as a script of the linker: verisq.symbols in the build folder. What the public headers
# name has the version VERISQ_x.y. The rest of the namespace verisq, which the project's own libraries and programs use
# among themselves, has VERISQ_PRIVATE_x.y: whoever links with that is bound to this very release. All else is hidden:
# what the headers of Boost, Eigen, fmt, JSON, pugixml and of the standard library leave in our objects.
set(public_symbols "${PROJECT_BINARY_DIR}/verisq.symbols")

# Appends what a header names as functions and types to the lists `functions` and `types`: calls in it, too, which does
# no harm.
macro(verisq_append_declared_names header)
  file(READ "${header}" text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "[][;]" " " text "${text}")
  string(REGEX MATCHALL "[A-Za-z_][A-Za-z_0-9]*[(]" calls "${text}")
  string(REGEX MATCHALL "(class|struct) [A-Za-z_0-9]+" declared "${text}")
  list(TRANSFORM calls REPLACE "[(]" "")
  list(TRANSFORM declared REPLACE "(class|struct) " "")
  list(APPEND functions ${calls})
  list(APPEND types ${declared})
endmacro()

file(GLOB headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/verisq/*.hpp")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${headers})
set(functions "")
set(types "")
foreach(header IN LISTS headers)
  verisq_append_declared_names("${header}")
endforeach()
list(REMOVE_DUPLICATES functions)
list(REMOVE_DUPLICATES types)

# Patterns of mangled names (Itanium C++ ABI, §5.1): demangled ones begin with what a function returns where it is made
# of a template. After a function's name comes the end of the name, a tag or a template's arguments; after a namespace's
# comes a number.
set(public "")
foreach(name IN LISTS functions)
  string(LENGTH "${name}" length)
  string(APPEND public "    _ZN6verisq${length}${name}[EBI]*;\n")
endforeach()
foreach(name IN LISTS types)
  string(LENGTH "${name}" length)
  foreach(kind IN ITEMS N NK)
    string(APPEND public "    _Z${kind}6verisq${length}${name}*;\n")
  endforeach()
  foreach(kind IN ITEMS TI TS TV)
    string(APPEND public "    _Z${kind}N6verisq${length}${name}E;\n")
  endforeach()
endforeach()
set(private "")
foreach(kind IN ITEMS N NK ZN ZNK TIN TSN TVN GVN GVZN GVZNK Thn*N)
  string(APPEND private "    _Z${kind}6verisq*;\n")
endforeach()
set(symbols_version "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")

# Of patterns that match one name the linker takes the last. Operators have two letters.
file(CONFIGURE OUTPUT "${public_symbols}" @ONLY CONTENT [[
VERISQ_PRIVATE_@symbols_version@ {
  global:
@private@  local:
    *;
};
VERISQ_@symbols_version@ {
  global:
    verisq_*;
    _ZN6verisq[a-z][a-z]E*;
@public@};
]])

# Programs see a library's own symbols and no others; whatever is missing is found where it is linked.
function(verisq_export_public_symbols)
  foreach(library IN LISTS ARGN)
    target_link_options(${library} PRIVATE LINKER:--version-script=${public_symbols} LINKER:--no-undefined)
    set_property(TARGET ${library} APPEND PROPERTY LINK_DEPENDS "${public_symbols}")
  endforeach()
endfunction()
