# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where: headers, libraries, find_package, pkg-config.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sunder)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core/sunder ${CMAKE_CURRENT_SOURCE_DIR}/sunder
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
install(TARGETS sunder EXPORT sunderTargets)
install(EXPORT sunderTargets NAMESPACE sunder:: DESTINATION ${config_dir})
if(SUNDER_SHARED)
  install(TARGETS sunder_shared EXPORT sunderSharedTargets)
  install(EXPORT sunderSharedTargets NAMESPACE sunder:: DESTINATION ${config_dir})
endif()
configure_package_config_file(sunderConfig.cmake.in sunderConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(sunderConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sunderConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/sunderConfigVersion.cmake DESTINATION ${config_dir})

# `sunder`: the C interface, shared if that is built. `sunder-cpp`: the C++ interface.
set(runtime "-lstdc++ -lm -ldl -lpthread")
if(SUNDER_SHARED)
  set(c_runtime "")
else()
  set(c_runtime "${runtime}")
endif()
configure_file(sunder.pc.in sunder.pc @ONLY)
configure_file(sunder-cpp.pc.in sunder-cpp.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sunder.pc ${CMAKE_CURRENT_BINARY_DIR}/sunder-cpp.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
