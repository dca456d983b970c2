# Finds Embree 3, for trees of boxes; defines Embree::embree.
# Installed beside springstabConfig.cmake: whoever links the static library needs it too.
find_path(Embree_INCLUDE_DIR embree3/rtcore.h)
find_library(Embree_LIBRARY embree3)
mark_as_advanced(Embree_INCLUDE_DIR Embree_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Embree REQUIRED_VARS Embree_LIBRARY Embree_INCLUDE_DIR)

if(Embree_FOUND AND NOT TARGET Embree::embree)
  add_library(Embree::embree UNKNOWN IMPORTED)
  set_target_properties(Embree::embree PROPERTIES IMPORTED_LOCATION "${Embree_LIBRARY}"
                                                  INTERFACE_INCLUDE_DIRECTORIES "${Embree_INCLUDE_DIR}")
endif()
