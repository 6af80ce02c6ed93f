# What `cmake --install` lays down besides the libraries and their headers: the command, the models and
# what find_package(pliant) reads. Each component is a package of Debian: see packages.cmake.

include(CMakePackageConfigHelpers)

if(TARGET pliant)
  set_target_properties(pliant PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
  install(TARGETS pliant COMPONENT runtime)
endif()
install(DIRECTORY experiments models DESTINATION share/pliant COMPONENT runtime)
install(DIRECTORY web/dist DESTINATION share/pliant/web COMPONENT runtime)
install(FILES LICENSE DESTINATION share/doc/pliant COMPONENT license)

install(EXPORT pliant NAMESPACE pliant:: FILE pliantTargets.cmake DESTINATION lib/cmake/pliant
        COMPONENT dev)
configure_package_config_file(cmake/pliantConfig.cmake.in pliantConfig.cmake
                              INSTALL_DESTINATION lib/cmake/pliant)
write_basic_package_version_file(pliantConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pliantConfig.cmake ${PROJECT_BINARY_DIR}/pliantConfigVersion.cmake
        DESTINATION lib/cmake/pliant COMPONENT dev)
