# Nothing may be left out silently: the suites inside the executable TESTS, the files test_*.cpp beside this
# script but for NOT_BUILT, and the list SUITES must name the same.
# --list_content prints one line per suite or case to stderr, nested ones indented.
execute_process(COMMAND ${TESTS} --list_content ERROR_VARIABLE content COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[A-Za-z_0-9]+" inside "${content}")
string(REPLACE "\n" "" inside "${inside}")
file(GLOB files RELATIVE ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/test_*.cpp)
list(TRANSFORM files REPLACE "^test_(.*)\\.cpp$" "\\1")
if(NOT_BUILT)
  list(REMOVE_ITEM files ${NOT_BUILT})
endif()
list(SORT inside)
list(SORT files)
list(SORT SUITES)
if(NOT inside STREQUAL SUITES OR NOT files STREQUAL SUITES)
  message(FATAL_ERROR "listed in tests/CMakeLists.txt: ${SUITES}\n"
                      "suites in the executable: ${inside}\nfiles tests/test_*.cpp: ${files}")
endif()
