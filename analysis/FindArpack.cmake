# Finds ARPACK-NG with its C interface (<arpack/arpack.h>) and defines Arpack::arpack.
# Installed beside springstabConfig.cmake: whoever links the static library needs it too.
find_path(Arpack_INCLUDE_DIR arpack/arpack.h)
find_library(Arpack_LIBRARY arpack)
mark_as_advanced(Arpack_INCLUDE_DIR Arpack_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Arpack REQUIRED_VARS Arpack_LIBRARY Arpack_INCLUDE_DIR)

if(Arpack_FOUND AND NOT TARGET Arpack::arpack)
  add_library(Arpack::arpack UNKNOWN IMPORTED)
  set_target_properties(
    Arpack::arpack PROPERTIES IMPORTED_LOCATION "${Arpack_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES
                                                                    "${Arpack_INCLUDE_DIR}")
endif()
