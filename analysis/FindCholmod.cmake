# Finds CHOLMOD, of SuiteSparse, with its supernodal module, METIS for its orders, and OpenBLAS under it; defines
# Cholmod::cholmod. All or none: without a fast BLAS and a good order the supernodal factorizations are no gain.
# Installed beside springstabConfig.cmake: whoever links the static library needs it too.
find_path(Cholmod_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(Cholmod_LIBRARY cholmod)
find_path(Cholmod_METIS_INCLUDE_DIR metis.h)
find_library(Cholmod_METIS_LIBRARY metis)
find_library(Cholmod_OPENBLAS_LIBRARY openblas)
mark_as_advanced(Cholmod_INCLUDE_DIR Cholmod_LIBRARY Cholmod_METIS_INCLUDE_DIR Cholmod_METIS_LIBRARY
                 Cholmod_OPENBLAS_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  Cholmod REQUIRED_VARS Cholmod_LIBRARY Cholmod_OPENBLAS_LIBRARY Cholmod_METIS_LIBRARY Cholmod_INCLUDE_DIR
                        Cholmod_METIS_INCLUDE_DIR)

if(Cholmod_FOUND AND NOT TARGET Cholmod::cholmod)
  add_library(Cholmod::cholmod UNKNOWN IMPORTED)
  set_target_properties(
    Cholmod::cholmod
    PROPERTIES IMPORTED_LOCATION "${Cholmod_LIBRARY}"
               INTERFACE_INCLUDE_DIRECTORIES "${Cholmod_INCLUDE_DIR};${Cholmod_METIS_INCLUDE_DIR}"
               INTERFACE_LINK_LIBRARIES "${Cholmod_OPENBLAS_LIBRARY};${Cholmod_METIS_LIBRARY};${CMAKE_DL_LIBS}")
endif()
