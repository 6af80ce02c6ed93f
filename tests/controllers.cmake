pliant_test(controllers/collision_damper_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/compliance_qp_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/frame_task_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/joint_damper_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/pose_reference_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/posture_task_test.cc LIBRARIES pliant::controllers)
pliant_test(controllers/qp_solver_test.cc LIBRARIES pliant::controllers)

# Exact arithmetic, an oracle for tests only; its headers ask for options of their own.
find_package(CGAL REQUIRED)
pliant_test(controllers/qp_exact_test.cc LIBRARIES pliant::controllers CGAL::CGAL)
pliant_test(controllers/low_level_torque_test.cc LIBRARIES pliant::controllers)
