# Install and export rules: the package `verisq` with the target verisq::verisq, for CMake and pkg-config, and the
# programs. The Python package installs itself (python/CMakeLists.txt).
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/verisq")

# From what a program is linked with to what it needs.
set(libraries verisq verisq_verify verisq_readers verisq_placement verisq_bend_range verisq_proof)
set(programs verisq_program verisq_check)
if(TARGET verisq_surface)
  list(APPEND libraries verisq_surface)
  list(APPEND programs verisq_surface_program)
else()
  set(headers_left_out PATTERN surface.hpp EXCLUDE PATTERN label_surface.hpp EXCLUDE PATTERN canal.hpp EXCLUDE)
endif()

# Shared libraries (BUILD_SHARED_LIBS): before 1.0 each minor version has an interface of its own. Sources are compiled
# as for static ones.
set_target_properties(${libraries} PROPERTIES VERSION ${PROJECT_VERSION} DEFINE_SYMBOL ""
                                              SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(BUILD_SHARED_LIBS)
  # Wherever all of it is moved to.
  file(RELATIVE_PATH from_programs "/${CMAKE_INSTALL_BINDIR}" "/${CMAKE_INSTALL_LIBDIR}")
  set_target_properties(${libraries} PROPERTIES INSTALL_RPATH "$ORIGIN")
  set_target_properties(${programs} PROPERTIES INSTALL_RPATH "$ORIGIN/${from_programs}")
  if(TARGET _verisq)
    file(RELATIVE_PATH from_module "/${VERISQ_PYTHON_INSTALL_DIR}/verisq" "/${CMAKE_INSTALL_LIBDIR}")
    set_target_properties(_verisq PROPERTIES INSTALL_RPATH "$ORIGIN/${from_module}")
  endif()
endif()

install(TARGETS ${libraries} EXPORT verisqTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/verisq DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${headers_left_out})
install(EXPORT verisqTargets NAMESPACE verisq:: DESTINATION ${package_dir})
configure_package_config_file(cmake/verisqConfig.cmake.in verisqConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(verisqConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/verisqConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/verisqConfigVersion.cmake
              cmake/FindMPFR.cmake cmake/FindNLopt.cmake
        DESTINATION ${package_dir})

# Static libraries are linked together with all that they use.
set(package_libs "-lverisq -lverisq_verify -lverisq_readers -lverisq_placement -lverisq_bend_range -lverisq_proof")
set(package_requires "")
if(NOT BUILD_SHARED_LIBS)
  set(package_requires "mpfr nlopt fmt pugixml cairo zlib")
  string(APPEND package_libs " -lgmp -ldl -pthread")
endif()
file(RELATIVE_PATH package_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file(cmake/verisq.pc.in verisq.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/verisq.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
