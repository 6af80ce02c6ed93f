find_package(nlohmann_json REQUIRED)

pliant_test(analysis/figure_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/linearize_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/report_test.cc LIBRARIES pliant::analysis nlohmann_json::nlohmann_json)
pliant_test(analysis/with_unit_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/compliance_prediction_test.cc LIBRARIES pliant::analysis)
pliant_test(analysis/null_space_compliance_test.cc LIBRARIES pliant::analysis)
