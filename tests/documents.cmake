# What the pages of docs/concepts show.
pliant_test(documents/blocks_test.cc LIBRARIES pliant::systems)
pliant_test(documents/time_test.cc LIBRARIES pliant::systems)
pliant_test(documents/signals_test.cc LIBRARIES pliant::systems)
pliant_test(documents/stations_test.cc LIBRARIES pliant::diagrams)
pliant_test(documents/failure_test.cc LIBRARIES pliant::controllers)
