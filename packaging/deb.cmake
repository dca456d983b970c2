# A Debian package of what is installed: `cpack -G DEB --config BUILD/CPackConfig.cmake`, of a build without
# SPRINGSTAB_NATIVE if it is for other machines. It depends on the libraries that dpkg-shlibdeps finds.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "The springstab developers <springstab@localhost>")
set(CPACK_PACKAGE_DESCRIPTION
    "Tells the largest stable time step of every integration method for a cloth, a scene or matrices, the damping
that goes with it, and runs the simulation at it. With headers and libraries for C++ programs. The binary is
linked with the GNU Scientific Library and so distributed under the GPL; the source is under the MIT licence.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS chromium)
install(
  FILES packaging/copyright
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
include(CPack)
