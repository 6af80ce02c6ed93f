# Debian packages of what is installed: `cpack --config build/release/CPackConfig.cmake -B packages` makes
#
#   libpliant        the libraries, the command, models, experiments, the pages of reports and runs
#   libpliant-dev    headers and what find_package(pliant) reads
#   python3-pliant   the Python module
#
# Version and changes are those of project() and CHANGELOG.md. The maintainer is who makes them, as
# Debian's own tools have it, DEBFULLNAME and DEBEMAIL, where they are set.
find_program(GZIP gzip)
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(FILE_TYPES file)
if(NOT PROJECT_IS_TOP_LEVEL OR NOT GZIP OR NOT DPKG_SHLIBDEPS OR NOT FILE_TYPES)
  return()
endif()

set(name "$ENV{DEBFULLNAME}")
set(address "$ENV{DEBEMAIL}")
if(NOT name)
  set(name "The pliant authors")
endif()
if(NOT address)
  set(address "pliant@localhost")
endif()
set(CPACK_PACKAGE_CONTACT "${name} <${address}>")

# The newest section of CHANGELOG.md as Debian writes it.
file(READ CHANGELOG.md changes)
string(REGEX REPLACE "^.*\n## ${PROJECT_VERSION}[^\n]*\n\n" "" changes "\n${changes}")
string(REGEX REPLACE "\n## .*$" "\n" changes "${changes}")
string(REGEX REPLACE "\n  " "\n    " changes "\n${changes}")
string(REGEX REPLACE "\n- " "\n  * " changes "${changes}")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(documents ${PROJECT_BINARY_DIR}/packages)
file(WRITE ${documents}/changelog
     "pliant (${PROJECT_VERSION}) unstable; urgency=medium\n${changes}\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
execute_process(COMMAND fmt -t -w 80 ${documents}/changelog COMMAND ${GZIP} -9n
                OUTPUT_FILE ${documents}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)

# What is inside the libraries and the pages has licences of its own.
file(READ LICENSE license)
file(READ web/dist/LICENSES.txt pages)
string(CONCAT copyright "pliant: ${license}\n\nIn /usr/share/pliant/web/dist: ${pages}")
set(sundials /usr/share/doc/libsundials-dev/copyright)
if(EXISTS ${sundials})
  file(READ ${sundials} text)
  string(APPEND copyright "\n\nLinked into the libraries, SUNDIALS:\n\n${text}")
endif()
file(WRITE ${documents}/copyright "${copyright}")

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime dev)
if(TARGET pliant_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
                                                GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# package(COMPONENT NAME SECTION CONTENT DEPENDS…): CONTENT is what the package has, in words.
function(package component name section content)
  string(TOUPPER ${component} COMPONENT)
  list(JOIN ARGN ", " depends)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${COMPONENT}_DESCRIPTION
      "The same diagram runs in an accurate simulation or at 1 kHz on an arm.\n${content}" PARENT_SCOPE)
  install(FILES ${documents}/changelog.gz ${documents}/copyright DESTINATION share/doc/${name}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

set(same "libpliant (= ${PROJECT_VERSION})")
package(runtime libpliant science
        "This package has the libraries, the command pliant, robot models and\nexperiments.")
file(WRITE ${documents}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${documents}/triggers)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "gnuplot-nox, graphviz")
package(dev libpliant-dev libdevel
        "This package has the headers and what CMake's find_package(pliant) reads."
        "${same}" "libeigen3-dev")
if(TARGET pliant_python)
  math(EXPR next "${PLIANT_PYTHON_MINOR} + 1")
  package(python python3-pliant python "This package has the module for Python 3.${PLIANT_PYTHON_MINOR}."
          "${same}" "python3 (>= 3.${PLIANT_PYTHON_MINOR})" "python3 (<< 3.${next})" "python3-numpy")
endif()
include(CPack)
