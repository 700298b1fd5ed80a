# SPDX-License-Identifier: MIT
# The runtime, all that ships in C++, and the Faust libraries of generated/, of the tree that this port is in. Without the program,
# which writes the other Faust libraries.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
vcpkg_check_features(OUT_FEATURE_OPTIONS features FEATURES
  simd CONTACTSPLINE_BUILD_SIMD
  threads CONTACTSPLINE_BUILD_THREADS)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}" OPTIONS ${features}
  -DCONTACTSPLINE_BUILD_GENERATOR=OFF -DCONTACTSPLINE_BUILD_DATASETS=OFF
  -DCONTACTSPLINE_BUILD_TESTS=OFF -DCONTACTSPLINE_BUILD_EXAMPLES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME ContactSpline CONFIG_PATH lib/cmake/ContactSpline)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
