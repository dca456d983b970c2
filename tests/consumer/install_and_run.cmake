# Installs BUILD (configuration CONFIG) below SCRATCH, then builds and runs the consumer against it.
# CMAKE_CXX_FLAGS is given empty: whatever the environment says, the consumer has no -march.
set(source ${CMAKE_CURRENT_LIST_DIR})
file(REMOVE_RECURSE ${SCRATCH})
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${SCRATCH}/prefix)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${source} -B ${SCRATCH}/build -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_CXX_FLAGS= -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/consumer)
run(${SCRATCH}/prefix/bin/springstab --version)
