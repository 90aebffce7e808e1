# Manual pages and completions, made of the programs' own help texts wherever there is a Python: man verisq-map.
find_program(Python3_EXECUTABLE python3)
if(NOT Python3_EXECUTABLE OR CMAKE_CROSSCOMPILING OR VERISQ_SANITIZE)
  return()
endif()
set(pages "${PROJECT_BINARY_DIR}/pages")
file(GLOB page_writers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/packaging/*.py")
set(page_programs $<TARGET_FILE:verisq_program> $<TARGET_FILE:verisq_check>)
set(page_targets verisq_program verisq_check)
if(TARGET verisq_surface_program)
  list(APPEND page_programs $<TARGET_FILE:verisq_surface_program>)
  list(APPEND page_targets verisq_surface_program)
endif()
add_custom_command(OUTPUT "${pages}.stamp"
                   COMMAND ${Python3_EXECUTABLE} -B "${PROJECT_SOURCE_DIR}/packaging/documents.py" "${pages}"
                           ${PROJECT_VERSION} ${page_programs}
                   COMMAND ${CMAKE_COMMAND} -E touch "${pages}.stamp"
                   DEPENDS ${page_targets} ${page_writers} COMMENT "Writing manual pages and completions" VERBATIM)
add_custom_target(verisq_pages ALL DEPENDS "${pages}.stamp")
# What `./run build` builds can be installed: the pages are installed with the programs.
add_dependencies(verisq_programs verisq_pages)

set(VERISQ_ZSH_COMPLETIONS_DIR "${CMAKE_INSTALL_DATAROOTDIR}/zsh/site-functions" CACHE STRING
    "Where zsh looks for completions, below the prefix (Debian's packages: share/zsh/vendor-completions)")
foreach(part IN ITEMS program surface)
  set(chosen PATTERN "*verisq-surface*" EXCLUDE)
  if(part STREQUAL "surface")
    if(NOT TARGET verisq_surface_program)
      continue()
    endif()
    set(chosen FILES_MATCHING PATTERN "*verisq-surface*")
  endif()
  install(DIRECTORY "${pages}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT ${part} ${chosen})
  install(DIRECTORY "${pages}/bash/" DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions"
          COMPONENT ${part} ${chosen})
  install(DIRECTORY "${pages}/zsh/" DESTINATION "${VERISQ_ZSH_COMPLETIONS_DIR}" COMPONENT ${part} ${chosen})
endforeach()
