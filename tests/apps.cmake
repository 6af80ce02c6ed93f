add_test(NAME apps/pliant
         COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/apps/pliant_test.py $<TARGET_FILE:pliant>)
