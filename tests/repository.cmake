# Tests of the repository as a whole: its layers, its style, its documents, what must not compile, and
# the installed library.

# repository_test(NAME ARGUMENT…): runs repository/NAME_test.py.
function(repository_test name)
  add_test(NAME repository/${name}
           COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/repository/${name}_test.py ${ARGN})
  set_tests_properties(repository/${name} PROPERTIES TIMEOUT ${pliant_test_timeout})
endfunction()

repository_test(layers ${PROJECT_SOURCE_DIR})
repository_test(style ${PROJECT_SOURCE_DIR})
repository_test(documents ${PROJECT_SOURCE_DIR})
repository_test(blocks ${PROJECT_SOURCE_DIR})
repository_test(trust ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})

if(PLIANT_SANITIZE)
  set(sanitize -fsanitize=${PLIANT_SANITIZE})
endif()
repository_test(install ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${CMAKE_CXX_COMPILER} ${sanitize})
# It compiles all examples.
set_tests_properties(repository/install PROPERTIES TIMEOUT 1800)

if(TARGET pliant)
  repository_test(gallery $<TARGET_FILE:pliant> ${PROJECT_SOURCE_DIR})
  add_test(NAME repository/commands
           COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/repository/documents_test.py
                   ${PROJECT_SOURCE_DIR} --run $<TARGET_FILE_DIR:pliant>)
endif()

file(GLOB sources CONFIGURE_DEPENDS compile_fail/*.cc)
foreach(source ${sources})
  cmake_path(GET source STEM name)
  add_test(NAME compile_fail/${name}
           COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/repository/compile_fail_test.py
                   ${source} ${CMAKE_CXX_COMPILER} -DPLIANT_MAX_JOINTS=${PLIANT_MAX_JOINTS}
                   -I${PROJECT_BINARY_DIR}/include -isystem ${EIGEN3_INCLUDE_DIR})
endforeach()

if(TARGET reference)
  add_test(NAME repository/reference COMMAND ${DOXYGEN} ${PROJECT_BINARY_DIR}/reference/Doxyfile
           WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/include)
  set_tests_properties(repository/reference PROPERTIES TIMEOUT ${pliant_test_timeout})
endif()

set(libraries)
foreach(folder systems plants estimators controllers diagrams analysis)
  list(APPEND libraries $<TARGET_FILE:pliant_${folder}>)
endforeach()
repository_test(symbols ${libraries})
