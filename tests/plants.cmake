find_package(PkgConfig REQUIRED)
pkg_check_modules(kdl REQUIRED IMPORTED_TARGET orocos-kdl)
find_package(urdfdom REQUIRED)
find_package(SUNDIALS REQUIRED)

pliant_test(plants/kdl_test.cc LIBRARIES pliant::plants PkgConfig::kdl urdfdom::urdfdom_model)
pliant_test(plants/robot_model_test.cc LIBRARIES pliant::plants)
pliant_test(plants/urdf_test.cc LIBRARIES pliant::plants)
pliant_test(plants/robot_dynamics_test.cc LIBRARIES pliant::plants)
pliant_test(plants/simbody_arm_test.cc LIBRARIES pliant::plants)
pliant_test(plants/free_motion_test.cc LIBRARIES pliant::plants)
pliant_test(plants/simbody_and_sundials_test.cc
            LIBRARIES pliant::plants SUNDIALS::arkode_static SUNDIALS::nvecserial_static)
# Symbols of the archives stay inside the program, or Simbody would find this SUNDIALS for its own.
target_link_options(plants_simbody_and_sundials_test PRIVATE LINKER:--exclude-libs,ALL)

pliant_test(plants/push_test.cc LIBRARIES pliant::plants)
pliant_test(plants/simbody_plant_test.cc LIBRARIES pliant::plants)
pliant_test(plants/link_force_test.cc LIBRARIES pliant::plants)
pliant_test(plants/hand_test.cc LIBRARIES pliant::plants)
pliant_test(plants/mass_on_rope_test.cc LIBRARIES pliant::plants)
pliant_test(plants/surface_test.cc LIBRARIES pliant::plants)
pliant_test(plants/joint_stops_test.cc LIBRARIES pliant::plants)
