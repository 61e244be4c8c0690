# Finds libtorch and makes the target sweepcast::torch of it. Its own package asks for what it was
# itself built with, and hands compiler flags on.
find_path(TORCH_INCLUDE_DIR torch/csrc/api/include/torch/torch.h)
find_library(TORCH_LIBRARY torch)
find_library(TORCH_CPU_LIBRARY torch_cpu)
find_library(C10_LIBRARY c10)
mark_as_advanced(TORCH_INCLUDE_DIR TORCH_LIBRARY TORCH_CPU_LIBRARY C10_LIBRARY)

set(torch_FOUND OFF)
set(torch_package libtorch-dev)
if(CMAKE_CXX_COMPILER_ID MATCHES Clang AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 16)
  set(torch_package "libtorch-dev, and build with g++: this clang cannot read it as C++20")
elseif(TORCH_INCLUDE_DIR AND TORCH_LIBRARY AND TORCH_CPU_LIBRARY AND C10_LIBRARY)
  set(torch_FOUND ON)
  add_library(sweepcast::torch UNKNOWN IMPORTED GLOBAL)
  set_target_properties(sweepcast::torch PROPERTIES IMPORTED_LOCATION "${TORCH_LIBRARY}")
  target_include_directories(sweepcast::torch SYSTEM INTERFACE
    "${TORCH_INCLUDE_DIR}" "${TORCH_INCLUDE_DIR}/torch/csrc/api/include")
  target_link_libraries(sweepcast::torch INTERFACE "${TORCH_CPU_LIBRARY}" "${C10_LIBRARY}")
endif()
