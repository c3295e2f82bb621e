# Installs the build folder BUILD below FOLDER, and runs a program that finds the package there.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/prefix)
foreach(file bin/npdr bin/npdr-infer lib/npdr_command.py lib/npdr_worker.py include/npdr_simulator.h share/npdr/docs/python.md
             share/npdr/python/npdr_posterior.py share/npdr/experiments/pendulum.toml)
  if(NOT EXISTS ${FOLDER}/prefix/${file})
    message(FATAL_ERROR "${file} isn't installed")
  endif()
endforeach()
# What the program prints, where man and shells look for it.
foreach(file share/man/man1/npdr.1 share/bash-completion/completions/npdr share/zsh/site-functions/_npdr
             share/fish/vendor_completions.d/npdr.fish)
  file(STRINGS ${FOLDER}/prefix/${file} lines REGEX "npdr evidence|__complete")
  if(lines STREQUAL "")
    message(FATAL_ERROR "${file} neither knows 'npdr evidence' nor asks npdr")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${FOLDER}/build -G Ninja -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_PREFIX_PATH=${FOLDER}/prefix)
run(${CMAKE_COMMAND} --build ${FOLDER}/build)
run(${FOLDER}/build/pendulum)
# The programs find what lies beside them, wherever they were installed.
run(${FOLDER}/prefix/bin/npdr validate ${FOLDER}/prefix/share/npdr/experiments/pendulum.toml)
