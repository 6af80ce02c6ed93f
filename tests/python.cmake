# The Python module as a user meets it.
if(TARGET pliant_python)
  foreach(name module numbers documents)
    add_test(NAME python/${name}
             COMMAND ${Python_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/python/${name}_test.py $<TARGET_FILE:pliant>)
    set_tests_properties(python/${name} PROPERTIES TIMEOUT 300 ENVIRONMENT
                                                   "PYTHONPATH=${PROJECT_BINARY_DIR}/python;MPLBACKEND=Agg")
  endforeach()
endif()
