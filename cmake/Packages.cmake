# Debian's packages of the installed parts, by CPack (`./run package`): each part is a package of its own, so that only
# verisq-surface and its development files are under the GPL, and that who links with the core alone gets no more.
set(debian_version ${PROJECT_VERSION})
set(soname ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME verisq)
set(CPACK_PACKAGE_VERSION ${debian_version})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "${VERISQ_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "")
foreach(library IN LISTS libraries)
  get_target_property(folder ${library} BINARY_DIR)
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${folder}")
endforeach()
list(REMOVE_DUPLICATES CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS)

# What `apt show` prints below the first line.
set(about "verisq encloses distances of points, triangles and meshes to models of
superquadrics, as of implants, by intervals that are proven to contain the
exact value; it also fits an implant into a bone and proves what it found.")
# What CPack does not write: the run-time linker learns of new libraries.
file(WRITE "${PROJECT_BINARY_DIR}/debian/triggers" "activate-noawait ldconfig\n")

# The changelog in the form of Debian; what changed is in CHANGELOG.md.
string(TIMESTAMP debian_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT debian/changelog @ONLY CONTENT "verisq (@debian_version@) unstable; urgency=medium

  * What changed is in /usr/share/doc/verisq/CHANGELOG.md.gz.

 -- @VERISQ_MAINTAINER@  @debian_date@
")
function(verisq_compress file compressed)
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/debian")
  execute_process(COMMAND gzip -9 --no-name --stdout "${file}" OUTPUT_FILE "${PROJECT_BINARY_DIR}/debian/${compressed}"
                  COMMAND_ERROR_IS_FATAL ANY)
endfunction()
verisq_compress("${PROJECT_BINARY_DIR}/debian/changelog" changelog.gz)
verisq_compress("${PROJECT_SOURCE_DIR}/CHANGELOG.md" CHANGELOG.md.gz)

# verisq_package(COMPONENT NAME SECTION SUMMARY [DEPENDS COMPONENT...] [ON PACKAGE...] [RECOMMENDS PACKAGE...]
# [SUGGESTS PACKAGE...]): ON are packages that dpkg-shlibdeps does not find.
set(packaged "")
macro(verisq_package component name section summary)
  cmake_parse_arguments(given "" "" "DEPENDS;ON;RECOMMENDS;SUGGESTS" ${ARGN})
  string(TOUPPER ${component} upper)
  list(APPEND packaged ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${about}")
  set(CPACK_COMPONENT_${upper}_DEPENDS ${given_DEPENDS})
  list(JOIN given_ON ", " CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS)
  list(JOIN given_RECOMMENDS ", " CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS)
  list(JOIN given_SUGGESTS ", " CPACK_DEBIAN_${upper}_PACKAGE_SUGGESTS)
  if(${component} MATCHES "^(core|library|surface)$")
    set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/debian/triggers")
  endif()
  set(documents "${CMAKE_INSTALL_DATAROOTDIR}/doc/${name}")
  set(copyright copyright)
  if(${component} MATCHES "^surface")
    set(copyright copyright_surface)
  endif()
  install(FILES packaging/${copyright} DESTINATION ${documents} RENAME copyright COMPONENT ${component})
  install(FILES "${PROJECT_BINARY_DIR}/debian/changelog.gz" DESTINATION ${documents} COMPONENT ${component})
endmacro()

set(opencl ocl-icd-libopencl1 pocl-opencl-icd)
verisq_package(program verisq science "guaranteed distances for whole meshes"
               DEPENDS library SUGGESTS verisq-surface python3-verisq)
verisq_package(core libverisq-core${soname} libs "guaranteed distances for whole meshes: core of the library"
               RECOMMENDS ${opencl})
verisq_package(library libverisq${soname} libs "guaranteed distances for whole meshes: library" DEPENDS core)
verisq_package(development libverisq-dev libdevel "guaranteed distances for whole meshes: development files"
               DEPENDS core library)
if(TARGET verisq_python)
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import sys; v = sys.version_info; \
print(f'python3 (>= {v[0]}.{v[1]});python3 (<< {v[0]}.{v[1] + 1})', end='')"
                  OUTPUT_VARIABLE this_python COMMAND_ERROR_IS_FATAL ANY)
  verisq_package(python python3-verisq python "guaranteed distances for whole meshes: Python 3 module"
                 DEPENDS library ON ${this_python} python3-numpy)
endif()
if(TARGET verisq_surface)
  verisq_package(surface verisq-surface science "surfaces of point clouds and damaged meshes (GPL)" DEPENDS library)
  verisq_package(surface_development libverisq-surface-dev libdevel
                 "surfaces of point clouds and damaged meshes (GPL): development files" DEPENDS surface development)
endif()

# What the programs' readers want to have at hand.
set(documents "${CMAKE_INSTALL_DATAROOTDIR}/doc/verisq")
install(FILES "${PROJECT_BINARY_DIR}/debian/CHANGELOG.md.gz" README.md DESTINATION ${documents} COMPONENT program)
install(DIRECTORY docs DESTINATION ${documents} COMPONENT program FILES_MATCHING PATTERN "*.md")
install(DIRECTORY examples DESTINATION ${documents} COMPONENT program PATTERN python EXCLUDE PATTERN cpp EXCLUDE
        PATTERN c EXCLUDE)
install(DIRECTORY examples/cpp examples/c DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libverisq-dev/examples
        COMPONENT development)
if(TARGET verisq_python)
  install(DIRECTORY examples/python/ DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/python3-verisq/examples
          COMPONENT python)
endif()

set(CPACK_COMPONENTS_ALL ${packaged})
include(CPack)
