pliant_test(systems/low_pass_test.cc LIBRARIES pliant::systems)
