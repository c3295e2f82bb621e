# What `cmake --install` gives besides the programs, and `cpack` packs: the libraries with their headers and a
# package for find_package(npdr), documents, studies, readers of posteriors, what the program says of itself to man
# and shells.
include(CMakePackageConfigHelpers)
set(package lib/cmake/npdr)
foreach(library core sim inference analysis)
  set_target_properties(npdr_${library} PROPERTIES EXPORT_NAME ${library})
  install(DIRECTORY ${library} DESTINATION include/npdr FILES_MATCHING PATTERN "*.h"
          PATTERN mujoco EXCLUDE PATTERN library EXCLUDE)
endforeach()
set_target_properties(npdr_flags PROPERTIES EXPORT_NAME flags)
install(TARGETS npdr_flags npdr_core npdr_sim npdr_inference npdr_analysis EXPORT npdr ARCHIVE DESTINATION lib)
install(EXPORT npdr NAMESPACE npdr:: FILE npdrTargets.cmake DESTINATION ${package})
configure_package_config_file(cmake/npdrConfig.cmake.in ${PROJECT_BINARY_DIR}/npdrConfig.cmake
                              INSTALL_DESTINATION ${package})
# Headers may change with any version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/npdrConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/npdrConfig.cmake ${PROJECT_BINARY_DIR}/npdrConfigVersion.cmake
              cmake/NpdrLibraryDependencies.cmake DESTINATION ${package})
# Where their links to each other hold. Not in share/doc, which small systems leave out.
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION share/npdr)
install(DIRECTORY docs experiments python DESTINATION share/npdr PATTERN __pycache__ EXCLUDE)

# npdr_install_words(<file> <folder> <word>...): what `npdr <word>...` prints, as a file.
function(npdr_install_words file folder)
  set(path ${PROJECT_BINARY_DIR}/share/${file})
  list(JOIN ARGN " " words)
  install(CODE "file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share)
                execute_process(COMMAND $<TARGET_FILE:npdr> ${words} OUTPUT_FILE ${path} COMMAND_ERROR_IS_FATAL ANY)")
  install(FILES ${path} DESTINATION ${folder})
endfunction()
set(NPDR_ZSH_COMPLETIONS share/zsh/site-functions CACHE STRING
    "Folder that zsh finds functions in, below the prefix; Debian's packages have another")
npdr_install_words(npdr.1 share/man/man1 man)
npdr_install_words(npdr share/bash-completion/completions completion bash)
npdr_install_words(_npdr ${NPDR_ZSH_COMPLETIONS} completion zsh)
npdr_install_words(npdr.fish share/fish/vendor_completions.d completion fish)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The npdr developers")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS gnuplot-nox)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, pkg-config, libeigen3-dev, libsundials-dev, libbullet-dev, \
libnlopt-dev, libnlopt-cxx-dev, libfmt-dev")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
include(CPack)
