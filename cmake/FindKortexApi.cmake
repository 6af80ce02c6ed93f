# Kinova's C++ SDK as its archive unpacks: include/ with a folder for each kind of header, and
# lib/release/libKortexApiCpp.a with the protobuf it was made with. -DKortexApi_DIR= names the folder
# that has both. Gives KortexApi::KortexApi.
find_path(KortexApi_INCLUDE_DIR client_stubs/BaseCyclicClientRpc.h
          HINTS ${KortexApi_DIR} ENV KortexApi_DIR PATH_SUFFIXES include NO_DEFAULT_PATH)
find_library(KortexApi_LIBRARY KortexApiCpp
             HINTS ${KortexApi_DIR} ENV KortexApi_DIR PATH_SUFFIXES lib/release lib NO_DEFAULT_PATH)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KortexApi REQUIRED_VARS KortexApi_LIBRARY KortexApi_INCLUDE_DIR)

if(KortexApi_FOUND AND NOT TARGET KortexApi::KortexApi)
  find_package(Threads REQUIRED)
  add_library(KortexApi::KortexApi UNKNOWN IMPORTED)
  set(folders ${KortexApi_INCLUDE_DIR})
  foreach(folder client client_stubs common google messages)
    list(APPEND folders ${KortexApi_INCLUDE_DIR}/${folder})
  endforeach()
  set_target_properties(KortexApi::KortexApi PROPERTIES
                        IMPORTED_LOCATION ${KortexApi_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES "${folders}"
                        INTERFACE_COMPILE_DEFINITIONS _OS_UNIX
                        INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS}")
endif()
