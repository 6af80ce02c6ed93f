pliant_test(estimators/complementary_fusion_test.cc LIBRARIES pliant::estimators)
pliant_test(estimators/momentum_observer_test.cc LIBRARIES pliant::diagrams)
pliant_test(estimators/super_twisting_observer_test.cc LIBRARIES pliant::estimators)
pliant_test(estimators/tool_compensation_test.cc LIBRARIES pliant::estimators)
