# Found by find_package(springstab): defines springstab::solvers and springstab::analysis.
# The libraries are static, so what they link privately is looked up here as well.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(GSL)
list(PREPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
find_dependency(Arpack)
list(POP_FRONT CMAKE_MODULE_PATH)
include(${CMAKE_CURRENT_LIST_DIR}/springstabTargets.cmake)
