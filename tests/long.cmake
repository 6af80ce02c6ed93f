# What runs for as long as one has; its tests are the shortest runs of it.
add_executable(gen3_fuzz EXCLUDE_FROM_ALL long/gen3_fuzz.cc)
target_link_libraries(gen3_fuzz PRIVATE pliant_options pliant::diagrams pliant_kortex GTest::gtest)

add_executable(soak long/soak.cc)
target_link_libraries(soak PRIVATE pliant_options pliant::diagrams)
target_compile_options(soak PRIVATE ${pliant_test_options})
add_test(NAME long/soak COMMAND soak 10000 4 2)
set_tests_properties(long/soak PROPERTIES TIMEOUT ${pliant_test_timeout})

set_target_properties(gen3_fuzz soak PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)

# Whether each mutation of a sign still can be made; what they tell takes an hour.
add_test(NAME long/mutations COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/long/mutate.py
                                     ${PROJECT_SOURCE_DIR} --check)
