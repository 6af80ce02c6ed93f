# The interactive part of a report, and the page of a run that goes on. Their packages are installed
# into a folder of the build; what is missing here leaves out the tests that need it, and is named.

find_program(NODE node)
find_program(NPM npm)
find_program(CHROMIUM NAMES chromium chromium-browser)

set(web ${PROJECT_SOURCE_DIR}/web)
set(web_build ${PROJECT_BINARY_DIR}/web)

# web_test(NAME ARGUMENT…): runs a file of web/test by node.
function(web_test name file)
  add_test(NAME web/${name} COMMAND ${NODE} ${file} ${ARGN})
  set_tests_properties(web/${name} PROPERTIES TIMEOUT 900)
endfunction()

if(NODE)
  add_executable(analysis_page_data_sample analysis/page_data_sample.cc)
  target_link_libraries(analysis_page_data_sample PRIVATE pliant_options pliant::analysis)
  set_target_properties(analysis_page_data_sample PROPERTIES RUNTIME_OUTPUT_DIRECTORY
                                                             ${PROJECT_BINARY_DIR}/tests)
  web_test(page_data ${web}/test/page_data_test.mjs $<TARGET_FILE:analysis_page_data_sample>
           ${web_build}/page_data)
  web_test(parts ${web}/test/parts_test.mjs)
endif()

if(NODE AND NPM)
  web_test(packages ${web}/test/packages.mjs ${web} ${web_build})
  set_tests_properties(web/packages PROPERTIES FIXTURES_SETUP web_packages)
  web_test(rebuild ${web_build}/test/rebuild_test.mjs ${web}/dist)
  web_test(foxglove ${web_build}/test/foxglove_test.mjs $<TARGET_FILE:pliant>
           ${PROJECT_SOURCE_DIR}/examples/live_arm.yaml)
  set_tests_properties(web/rebuild web/foxglove PROPERTIES FIXTURES_REQUIRED web_packages)
endif()

if(NODE AND NPM AND CHROMIUM)
  web_test(page ${web_build}/test/page_test.mjs ${web}/dist ${web_build}/page ${CHROMIUM})
  web_test(report ${web_build}/test/report_test.mjs $<TARGET_FILE:pliant> ${web_build}/page ${CHROMIUM})
  web_test(live_page ${web_build}/test/live_page_test.mjs ${web}/dist ${CHROMIUM})
  web_test(live ${web_build}/test/live_test.mjs $<TARGET_FILE:pliant>
           ${PROJECT_SOURCE_DIR}/examples/live_arm.yaml ${web_build}/live ${CHROMIUM})
  set_tests_properties(web/page web/report web/live_page web/live
                       PROPERTIES FIXTURES_REQUIRED web_packages)
else()
  message(STATUS "The pages of reports and runs are tested only in part: node, npm and chromium "
                 "would be needed; found ${NODE}, ${NPM}, ${CHROMIUM}")
endif()
