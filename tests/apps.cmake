# The command is no library: a test compiles the unit it is about.
find_package(SDL2 REQUIRED)
pliant_test(apps/arm_check_test.cc LIBRARIES pliant::plants pliant_kortex)
target_sources(apps_arm_check_test PRIVATE ${PROJECT_SOURCE_DIR}/apps/arm_check.cc)
pliant_test(apps/doctor_checks_test.cc LIBRARIES pliant::systems)
target_sources(apps_doctor_checks_test PRIVATE ${PROJECT_SOURCE_DIR}/apps/doctor_checks.cc)
pliant_test(apps/pad_device_test.cc LIBRARIES pliant::controllers SDL2::SDL2)
target_sources(apps_pad_device_test PRIVATE ${PROJECT_SOURCE_DIR}/apps/pad_device.cc)
pliant_test(apps/progress_line_test.cc LIBRARIES pliant::analysis)

# The command as a user meets it.
if(TARGET pliant)
  pliant_test(apps/recover_test.cc LIBRARIES pliant::plants pliant_kortex)
  target_compile_definitions(apps_recover_test PRIVATE PLIANT_COMMAND="$<TARGET_FILE:pliant>")
  add_dependencies(apps_recover_test pliant)
  foreach(name arm_run damage doctor emulate emulate_gen3 graph hardware identify identify_dynamics interruption output own_arm scenario sweep)
    add_test(NAME apps/${name}
             COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/apps/${name}_test.py $<TARGET_FILE:pliant>)
    set_tests_properties(apps/${name} PROPERTIES TIMEOUT ${pliant_test_timeout})
  endforeach()

  # Each experiment on the papers, held against the table of docs/experiments.md; what takes minutes
  # has its command there.
  file(GLOB experiments CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/experiments
       ${PROJECT_SOURCE_DIR}/experiments/*.yaml)
  list(TRANSFORM experiments REPLACE "\\.yaml$" "")
  list(REMOVE_ITEM experiments ec-fig5 rss-drop ns-c)
  foreach(name ${experiments})
    add_test(NAME experiments/${name}
             COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/apps/experiments_test.py
                     $<TARGET_FILE:pliant> ${PROJECT_SOURCE_DIR} ${name})
    set_tests_properties(experiments/${name} PROPERTIES TIMEOUT ${pliant_test_timeout})
  endforeach()
endif()
