# Installs BUILD (configuration CONFIG) into a folder of its own beside SCRATCH, then builds and runs the
# consumers against it. Where all goes well nothing is left.
# CMAKE_CXX_FLAGS is given empty: whatever the environment says, the consumer has the flags of the library.
set(source ${CMAKE_CURRENT_LIST_DIR})
string(RANDOM LENGTH 12 own)
string(APPEND SCRATCH -${own})
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${SCRATCH}/prefix)

function(consume name)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${source} -B ${SCRATCH}/${name} -D CMAKE_BUILD_TYPE=Release
      -D CMAKE_CXX_FLAGS= -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix ${ARGN})
  run(${CMAKE_COMMAND} --build ${SCRATCH}/${name})
  run(${SCRATCH}/${name}/consumer)
endfunction()
consume(all)
# What is not to be asked for is not there.
consume(solvers -D COMPONENTS=solvers -D CMAKE_DISABLE_FIND_PACKAGE_GSL=ON
        -D CMAKE_DISABLE_FIND_PACKAGE_Arpack=ON)

# The command knows the plots that were installed with it.
run(${SCRATCH}/prefix/bin/springstab --version)
file(REAL_PATH ${SCRATCH}/prefix prefix)
execute_process(COMMAND ${prefix}/bin/springstab figures --help OUTPUT_VARIABLE help
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "--plots DIR=([^ \n]+)" shown "${help}")
set(plots ${CMAKE_MATCH_1})
cmake_path(IS_PREFIX prefix "${plots}" installed)
if(NOT installed OR NOT EXISTS ${plots}/region.gp)
  message(FATAL_ERROR "the installed command looks for its plots in '${plots}', expected a folder with "
                      "region.gp below ${prefix}")
endif()
file(REMOVE_RECURSE ${SCRATCH})
