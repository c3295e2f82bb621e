# Run at build time: writes the git revision into a header, and touches it only when it changes.
# Without git, or outside of a checkout, the revision is "unknown".
set(NPDR_GIT_REVISION "unknown")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE
                  RESULT_VARIABLE status ERROR_QUIET)
  if(status EQUAL 0 AND output)
    set(NPDR_GIT_REVISION "${output}")
  endif()
endif()
configure_file(${TEMPLATE} ${HEADER} @ONLY)
