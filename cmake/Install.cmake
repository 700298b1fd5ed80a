# What `cmake --install` lays down beside the shipped files: program, headers, CMake package, pkg-config file. All of
# it can be moved afterwards.
include(CMakePackageConfigHelpers)

set(contactspline_data_dir ${CMAKE_INSTALL_DATADIR}/contactspline)
set(contactspline_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/ContactSpline)
set(CONTACTSPLINE_PKGCONFIG_DIR ${CMAKE_INSTALL_DATADIR}/pkgconfig CACHE STRING "Folder of the files of pkg-config, below the prefix")

install(TARGETS contactspline_runtime contactspline_materials EXPORT ContactSplineTargets
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(NOT CONTACTSPLINE_BUILD_SIMD)
  install(TARGETS contactspline_engine EXPORT ContactSplineTargets)
endif()
if(CONTACTSPLINE_BUILD_GENERATOR)
  install(TARGETS contactspline EXPORT ContactSplineTargets COMPONENT program)
endif()
install(FILES runtime/contactspline.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY runtime/contactspline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN *.hpp PATTERN simd/*-inl.hpp EXCLUDE)
install(DIRECTORY data/materials data/frictions data/resonators data/scores data/keyboards data/instruments DESTINATION ${contactspline_data_dir}
        FILES_MATCHING PATTERN *.json PATTERN *.csv PATTERN *.mid)
install(FILES LICENSE TYPE DOC COMPONENT licence)

install(EXPORT ContactSplineTargets NAMESPACE ContactSpline:: DESTINATION ${contactspline_cmake_dir})
if(CONTACTSPLINE_BUILD_SIMD)
  install(TARGETS contactspline_simd contactspline_engine EXPORT ContactSplineSimdTargets)
  install(EXPORT ContactSplineSimdTargets NAMESPACE ContactSpline:: DESTINATION ${contactspline_cmake_dir})
endif()
if(CONTACTSPLINE_BUILD_THREADS)
  install(TARGETS contactspline_threads EXPORT ContactSplineThreadsTargets)
  install(EXPORT ContactSplineThreadsTargets NAMESPACE ContactSpline:: DESTINATION ${contactspline_cmake_dir})
endif()
if(CONTACTSPLINE_BUILD_C)
  install(EXPORT ContactSplineCTargets NAMESPACE ContactSpline:: DESTINATION ${contactspline_cmake_dir} COMPONENT c_development)
endif()
configure_package_config_file(cmake/ContactSplineConfig.cmake.in ContactSplineConfig.cmake
  INSTALL_DESTINATION ${contactspline_cmake_dir}
  PATH_VARS contactspline_data_dir)
write_basic_package_version_file(ContactSplineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/ContactSplineConfig.cmake ${PROJECT_BINARY_DIR}/ContactSplineConfigVersion.cmake
  cmake/ContactSplineArguments.cmake cmake/ContactSplineFaust.cmake cmake/ContactSplineGenerate.cmake
  cmake/ContactSplineModel.cmake
  cmake/ContactSplinePlugin.cmake
  DESTINATION ${contactspline_cmake_dir})
# What contactspline_plugin() compiles.
install(DIRECTORY hosts/plugin DESTINATION ${contactspline_data_dir} PATTERN CMakeLists.txt EXCLUDE)

# From the file's own folder to the prefix, whatever the folders are called.
set(contactspline_pkgconfig_to_prefix ${CMAKE_INSTALL_PREFIX})
cmake_path(RELATIVE_PATH contactspline_pkgconfig_to_prefix
           BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX}/${CONTACTSPLINE_PKGCONFIG_DIR})
configure_file(cmake/contactspline.pc.in contactspline.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/contactspline.pc DESTINATION ${CONTACTSPLINE_PKGCONFIG_DIR})
if(CONTACTSPLINE_BUILD_SIMD)
  configure_file(cmake/contactspline-simd.pc.in contactspline-simd.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/contactspline-simd.pc DESTINATION ${CONTACTSPLINE_PKGCONFIG_DIR})
endif()
if(CONTACTSPLINE_BUILD_C)
  configure_file(cmake/contactspline-c.pc.in contactspline-c.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/contactspline-c.pc DESTINATION ${CONTACTSPLINE_PKGCONFIG_DIR} COMPONENT c_development)
endif()
