pliant_test(diagrams/compliance_loop_test.cc LIBRARIES pliant::diagrams)
pliant_test(diagrams/simulated_arm_test.cc LIBRARIES pliant::diagrams)
pliant_test(diagrams/sway_loop_test.cc LIBRARIES pliant::diagrams)
