find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)

pliant_test(analysis/bootstrap_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/difference_claim_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/distributions_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/equivalence_claim_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/equivalence_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/export_test.cc LIBRARIES pliant::analysis)
# The one that Debian's h5py is for; another may come first.
find_program(PLIANT_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(PLIANT_PYTHON python3 REQUIRED)
mark_as_advanced(PLIANT_PYTHON)
target_compile_definitions(analysis_export_test PRIVATE PLIANT_PYTHON="${PLIANT_PYTHON}")
pliant_test(analysis/figure_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/high_pass_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/linearize_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mann_whitney_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/log_file_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mcap_bad_sector_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mcap_damage_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mcap_reader_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mcap_repair_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/order_claim_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/recording_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/repeated_number_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/replay_of_an_arm_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/replay_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/shapiro_wilk_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/signal_number_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/summary_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/page_data_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/report_test.cc LIBRARIES pliant::analysis nlohmann_json::nlohmann_json)
pliant_test(analysis/with_unit_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/compliance_prediction_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/null_space_compliance_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mass_drop_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/bound_claim_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/compliance_claims_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/experiment_figures_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/experiment_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/run_experiment_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/work_precision_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/integrator_study_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/parameter_schema_test.cc
            LIBRARIES pliant::plants nlohmann_json::nlohmann_json)
pliant_test(analysis/ros_schema_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/row_ring_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/mcap_log_test.cc LIBRARIES pliant::analysis ZLIB::ZLIB ${ZSTD_LIBRARY})
target_include_directories(analysis_mcap_log_test SYSTEM PRIVATE ${ZSTD_INCLUDE})

# Logs, read by the libraries of others.
add_executable(analysis_mcap_sample analysis/mcap/sample.cc)
target_link_libraries(analysis_mcap_sample PRIVATE pliant_options pliant::analysis
                                                   nlohmann_json::nlohmann_json)
set_target_properties(analysis_mcap_sample PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
add_test(NAME analysis/mcap
         COMMAND Python3::Interpreter -B ${CMAKE_CURRENT_SOURCE_DIR}/analysis/mcap/mcap_test.py
                 $<TARGET_FILE:analysis_mcap_sample> ${CMAKE_CURRENT_BINARY_DIR}/mcap)
set_tests_properties(analysis/mcap PROPERTIES TIMEOUT 600)

# The schema of experiment files, read by a validator.
add_executable(analysis_experiment_sample analysis/experiment_sample.cc)
target_link_libraries(analysis_experiment_sample PRIVATE pliant_options pliant::analysis)
set_target_properties(analysis_experiment_sample PROPERTIES RUNTIME_OUTPUT_DIRECTORY
                                                            ${PROJECT_BINARY_DIR}/tests)
add_test(NAME analysis/experiment_schema
         COMMAND ${PLIANT_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/analysis/experiment_schema_test.py
                 ${PROJECT_SOURCE_DIR} $<TARGET_FILE:analysis_experiment_sample>)
