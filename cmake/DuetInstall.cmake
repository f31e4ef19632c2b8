# cmake --install, and the package that find_package(duet) finds.

include(CMakePackageConfigHelpers)

get_property(duet_libraries GLOBAL PROPERTY DUET_LIBRARIES)
install(TARGETS ${duet_libraries} EXPORT duetTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET duet)
  install(TARGETS duet RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY common frontend backends evaluation
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/duet FILES_MATCHING PATTERN "*.h")
install(DIRECTORY experiments/simulation
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/duet/experiments FILES_MATCHING PATTERN "*.h")
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/duet)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(duet_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/duet)
install(EXPORT duetTargets NAMESPACE duet:: DESTINATION ${duet_cmake_dir})
configure_package_config_file(cmake/duetConfig.cmake.in "${PROJECT_BINARY_DIR}/duetConfig.cmake"
                              INSTALL_DESTINATION ${duet_cmake_dir})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/duetConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/duetConfig.cmake"
              "${PROJECT_BINARY_DIR}/duetConfigVersion.cmake"
              cmake/DuetDependencies.cmake cmake/FindOpenCVModules.cmake
        DESTINATION ${duet_cmake_dir})
