# Refuses compilers that are too old, in one line. To see what it makes of another one:
# cmake -DCMAKE_CXX_COMPILER_ID=GNU -DCMAKE_CXX_COMPILER_VERSION=11.4 -P cmake/Compiler.cmake
set(contactspline_oldest_GNU 12)
set(contactspline_oldest_Clang 14)
set(oldest "${contactspline_oldest_${CMAKE_CXX_COMPILER_ID}}")
if(oldest AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS oldest)
  message(FATAL_ERROR "Contact Spline needs g++ 12 or clang++ 14, or a later one; CMAKE_CXX_COMPILER is "
                      "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_CXX_COMPILER}")
endif()
