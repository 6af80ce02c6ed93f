# The reference of the public headers, by Doxygen and Debian's doxygen-awesome-css where they are:
#   cmake --build build/release --target reference    writes build/release/reference/html/index.html
find_program(DOXYGEN doxygen)
find_file(DOXYGEN_STYLE doxygen-awesome.css PATHS /usr/share/doxygen-awesome-css NO_DEFAULT_PATH)

if(DOXYGEN AND PROJECT_IS_TOP_LEVEL)
  get_property(headers GLOBAL PROPERTY pliant_public_headers)
  list(JOIN headers " " PLIANT_HEADERS)
  if(NOT DOXYGEN_STYLE)
    set(DOXYGEN_STYLE "")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/reference/Doxyfile @ONLY)
  add_custom_target(reference COMMAND ${DOXYGEN} ${PROJECT_BINARY_DIR}/reference/Doxyfile
                    WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/include VERBATIM
                    COMMENT "The reference: ${PROJECT_BINARY_DIR}/reference/html/index.html")
endif()
