# What fuzzers begin with and what they have found, through the same functions; the fuzzers themselves are
# made by the preset fuzz.
pliant_test(fuzz/corpus_test.cc LIBRARIES pliant::analysis pliant_kortex nlohmann_json::nlohmann_json)
file(GLOB targets CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus fuzz/corpus/*)
foreach(target ${targets})
  target_sources(fuzz_corpus_test PRIVATE fuzz/${target}.cc)
endforeach()
