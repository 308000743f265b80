# What `cpack` makes of a built tree, of what DynInstall installs: a .deb and a .tar.gz.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tests and benches need not be built for it
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME libdyn)
set(CPACK_PACKAGE_VENDOR "libdyn")
set(CPACK_PACKAGE_CONTACT "The libdyn developers <libdyn@localhost>")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}: library, C and C++ headers, command")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)  # and a postinst with ldconfig
find_program(DYN_SHLIBDEPS dpkg-shlibdeps)    # of dpkg-dev: the packages that hold the libraries that ours need
if(DYN_SHLIBDEPS)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
include(CPack)
