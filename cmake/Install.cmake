# Install and export rules: the package `verisq` with the target verisq::verisq and those of its components, for CMake
# and pkg-config, and the programs. The Python package installs itself (python/CMakeLists.txt). Each rule says of which
# part of the whole it is (COMPONENT), of which Packages.cmake makes Debian's packages.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/verisq")

# From what a program is linked with to what it needs.
set(core_libraries verisq_core verisq_verify verisq_writers verisq_readers verisq_proof verisq_proposals)
if(NOT BUILD_SHARED_LIBS)
  list(APPEND core_libraries verisq_opencl)
endif()
set(other_libraries verisq_report verisq_plan verisq_stance verisq_files verisq_map_readers)
set(libraries ${other_libraries} ${core_libraries})
set(programs verisq_program verisq_check)
if(TARGET verisq_surface)
  list(APPEND libraries verisq_surface)
  list(APPEND programs verisq_surface_program)
endif()

# Shared libraries (BUILD_SHARED_LIBS): before 1.0 each minor version has an interface of its own. Sources are compiled
# as for static ones.
set_target_properties(${libraries} PROPERTIES VERSION ${PROJECT_VERSION} DEFINE_SYMBOL ""
                                              SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(BUILD_SHARED_LIBS)
  verisq_export_public_symbols(${libraries})
  # Wherever all of it is moved to.
  file(RELATIVE_PATH from_programs "/${CMAKE_INSTALL_BINDIR}" "/${CMAKE_INSTALL_LIBDIR}")
  set_target_properties(${libraries} PROPERTIES INSTALL_RPATH "$ORIGIN")
  set_target_properties(${programs} PROPERTIES INSTALL_RPATH "$ORIGIN/${from_programs}")
  if(TARGET _verisq)
    file(RELATIVE_PATH from_module "/${VERISQ_PYTHON_INSTALL_DIR}/verisq" "/${CMAKE_INSTALL_LIBDIR}")
    set_target_properties(_verisq PROPERTIES INSTALL_RPATH "$ORIGIN/${from_module}")
  endif()
endif()

# verisq_install_libraries(EXPORT COMPONENT DEVELOPMENT_COMPONENT TARGET...)
function(verisq_install_libraries export component development)
  install(TARGETS ${ARGN} EXPORT ${export}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${development}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component} NAMELINK_COMPONENT ${development})
endfunction()
verisq_install_libraries(verisqTargets core development ${core_libraries})
verisq_install_libraries(verisqTargets library development verisq ${other_libraries})
install(TARGETS verisq_program verisq_check RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
if(TARGET verisq_mpi)
  install(TARGETS verisq_mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT mpi)
endif()
install(DIRECTORY include/verisq DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        PATTERN surface.hpp EXCLUDE)
install(EXPORT verisqTargets NAMESPACE verisq:: DESTINATION ${package_dir} COMPONENT development)

# What is linked with CGAL, in files of its own.
if(TARGET verisq_surface)
  verisq_install_libraries(verisqSurfaceTargets surface surface_development verisq_surface)
  install(TARGETS verisq_surface_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT surface)
  install(FILES include/verisq/surface.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/verisq COMPONENT surface_development)
  install(EXPORT verisqSurfaceTargets NAMESPACE verisq:: DESTINATION ${package_dir} COMPONENT surface_development)
endif()

configure_package_config_file(cmake/verisqConfig.cmake.in verisqConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(verisqConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/verisqConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/verisqConfigVersion.cmake
              cmake/FindMPFR.cmake cmake/FindNLopt.cmake
        DESTINATION ${package_dir} COMPONENT development)

# verisq_install_pc(NAME DESCRIPTION NEEDED COMPONENT [OWN LIBRARY...] [REQUIRES PC...] [LIBS FLAG...]): NAME.pc, of the
# libraries OWN, which need those of the .pc files NEEDED. REQUIRES and LIBS are what static ones are linked with, too.
file(RELATIVE_PATH package_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
function(verisq_install_pc name package_description package_requires component)
  cmake_parse_arguments(static "" "" "REQUIRES;LIBS;OWN" ${ARGN})
  set(package_libs ${static_OWN})
  list(TRANSFORM package_libs PREPEND "-l")
  if(NOT BUILD_SHARED_LIBS)
    list(APPEND package_requires ${static_REQUIRES})
    list(APPEND package_libs ${static_LIBS})
  endif()
  list(JOIN package_requires " " package_requires)
  list(JOIN package_libs " " package_libs)
  configure_file(cmake/verisq.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT ${component})
endfunction()
set(same "= ${PROJECT_VERSION}")
verisq_install_pc(verisq-core "${PROJECT_DESCRIPTION}: models, distances, maps" "" development
                  OWN ${core_libraries} REQUIRES mpfr fmt zlib LIBS -lgmp -ldl -pthread -lstdc++ -lm)
verisq_install_pc(verisq-files "${PROJECT_DESCRIPTION}: files in XML, volumes" "verisq-core ${same}" development
                  OWN verisq_files verisq_map_readers REQUIRES pugixml zlib)
verisq_install_pc(verisq-plan "${PROJECT_DESCRIPTION}: fits, insertions, features" "verisq-core ${same}" development
                  OWN verisq_plan REQUIRES nlopt)
verisq_install_pc(verisq-stance "${PROJECT_DESCRIPTION}: human stance" "verisq-core ${same}" development
                  OWN verisq_stance)
verisq_install_pc(verisq-report "${PROJECT_DESCRIPTION}: pages and pictures" "verisq-core ${same}" development
                  OWN verisq_report REQUIRES cairo)
verisq_install_pc(verisq "${PROJECT_DESCRIPTION}"
                  "verisq-report ${same} verisq-plan ${same} verisq-stance ${same} verisq-files ${same}" development)
if(TARGET verisq_surface)
  verisq_install_pc(verisq-surface "${PROJECT_DESCRIPTION}: surfaces by CGAL (GPL)" "verisq ${same}"
                    surface_development OWN verisq_surface)
endif()
