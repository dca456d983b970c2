cmake_minimum_required(VERSION 3.25)
# Writes FILE with the commit that SOURCE stands at, for the foot of timing figures; untouched where it has not changed.
execute_process(
  COMMAND git describe --always --dirty
  WORKING_DIRECTORY ${SOURCE}
  OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown commit")
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "#define SPRINGSTAB_COMMIT \"@commit@\"\n" @ONLY)
