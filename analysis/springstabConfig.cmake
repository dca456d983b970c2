# Found by find_package(springstab [COMPONENTS solvers analysis]): defines springstab::solvers, and
# springstab::analysis unless the components leave it out. The libraries are static, so what they link privately
# is looked up here as well: Eigen and, where it was there, Embree for both, GSL, ARPACK and CHOLMOD, likewise, for
# analysis alone.
include(CMakeFindDependencyMacro)
set(springstab_wanted ${springstab_FIND_COMPONENTS})
if(NOT springstab_wanted)
  set(springstab_wanted solvers analysis)
endif()

find_dependency(Eigen3 3.4)
list(PREPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
if(@embree_is_linked@)
  find_dependency(Embree)
endif()
include(${CMAKE_CURRENT_LIST_DIR}/springstab_solversTargets.cmake)
set(springstab_solvers_FOUND TRUE)
if(analysis IN_LIST springstab_wanted)
  find_dependency(GSL)
  find_dependency(Arpack)
  if(@cholmod_is_linked@)
    find_dependency(Cholmod)
  endif()
  include(${CMAKE_CURRENT_LIST_DIR}/springstab_analysisTargets.cmake)
  set(springstab_analysis_FOUND TRUE)
endif()
list(POP_FRONT CMAKE_MODULE_PATH)

foreach(component IN LISTS springstab_wanted)
  if(springstab_FIND_REQUIRED_${component} AND NOT springstab_${component}_FOUND)
    set(springstab_FOUND FALSE)
    set(springstab_NOT_FOUND_MESSAGE "springstab has no component '${component}', expected solvers or analysis")
  endif()
endforeach()
