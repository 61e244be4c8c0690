# Shared by the scripts beside it. SOURCE and BUILD are this project's, WORK is the tests' own.
set(PREFIX ${WORK}/prefix)

# run(COMMAND...): stops the script where the command fails.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# build(SOURCE FOLDER OPTIONS...): configures and builds a project in a fresh folder, without
# optimising: what is tested is how it is built and found.
function(build source folder)
  file(REMOVE_RECURSE ${folder})
  run(${CMAKE_COMMAND} -S ${source} -B ${folder} -G ${GENERATOR}
      -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG=-O0 ${ARGN})
  run(${CMAKE_COMMAND} --build ${folder})
endfunction()
