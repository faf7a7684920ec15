# SPDX-License-Identifier: Apache-2.0
# Installs the build into a folder of its own, then configures, builds and runs the outside project.
set(work ${build}/package_test)
file(REMOVE_RECURSE ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
  message("${output}")
endfunction()
run(${CMAKE_COMMAND} --install ${build} --prefix ${work}/installed)
run(${CMAKE_COMMAND} -S ${source} -B ${work}/outside -G ${generator}
  -D CMAKE_PREFIX_PATH=${work}/installed -D CMAKE_CXX_COMPILER=${compiler} "-DCMAKE_CXX_FLAGS=${flags}")
run(${CMAKE_COMMAND} --build ${work}/outside)
run(${work}/outside/outside)
run(${work}/outside/recommended)
run(${work}/outside/outside_recorder ${work}/log.mcap)
