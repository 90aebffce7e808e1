# Install and export rules: the package `verisq` with the target verisq::verisq, and the programs.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/verisq")

install(TARGETS verisq_proof verisq_bend_range verisq_placement verisq_verify verisq_readers verisq EXPORT verisqTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS verisq_program verisq_check RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET verisq_surface)
  install(TARGETS verisq_surface_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(TARGETS verisq_surface EXPORT verisqTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
else()
  set(headers_left_out PATTERN surface.hpp EXCLUDE)
endif()
install(DIRECTORY include/verisq DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${headers_left_out})
install(EXPORT verisqTargets NAMESPACE verisq:: DESTINATION ${package_dir})
configure_package_config_file(cmake/verisqConfig.cmake.in verisqConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(verisqConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/verisqConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/verisqConfigVersion.cmake
              cmake/FindMPFR.cmake cmake/FindNLopt.cmake
        DESTINATION ${package_dir})
