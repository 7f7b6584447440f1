# What is installed, and the Debian package made of it by cpack.
install(TARGETS sonoband sonoband-tool RUNTIME DESTINATION bin)
install(FILES ${CMAKE_SOURCE_DIR}/board/udev/70-sonoband.rules ${CMAKE_SOURCE_DIR}/board/sticks/70-sonoband-sticks.rules
  DESTINATION lib/udev/rules.d)
install(PROGRAMS ${CMAKE_SOURCE_DIR}/board/sticks/mount-stick ${CMAKE_SOURCE_DIR}/board/systemd/grow-data
  ${CMAKE_SOURCE_DIR}/board/systemd/stop-cart ${CMAKE_SOURCE_DIR}/board/systemd/x-server DESTINATION lib/sonoband)
install(FILES ${CMAKE_SOURCE_DIR}/board/sticks/sonoband-sticks.rules DESTINATION share/polkit-1/rules.d)
install(FILES ${CMAKE_SOURCE_DIR}/board/sticks/tmpfiles.conf DESTINATION lib/tmpfiles.d RENAME sonoband.conf)
install(FILES ${CMAKE_SOURCE_DIR}/board/systemd/sonoband.service
  ${CMAKE_SOURCE_DIR}/board/systemd/sonoband-grow-data.service DESTINATION lib/systemd/system)
install(FILES ${CMAKE_SOURCE_DIR}/README.md ${CMAKE_SOURCE_DIR}/board/systemd/board.example
  ${CMAKE_SOURCE_DIR}/board/systemd/fstab.example ${CMAKE_SOURCE_DIR}/LICENSE
  DESTINATION share/doc/sonoband)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/board/profiles ${CMAKE_SOURCE_DIR}/board/raspberrypi DESTINATION share/sonoband
  PATTERN make-cart EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sonoband)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The Sonoband developers <sonoband@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "freehand 3D ultrasound without voxels, at the cart")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  ${CMAKE_SOURCE_DIR}/board/debian/postinst ${CMAKE_SOURCE_DIR}/board/debian/prerm ${CMAKE_SOURCE_DIR}/board/debian/postrm)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "xserver-xorg-core, xserver-xorg-input-libinput, xinit, systemd-timesyncd, libpam-systemd, polkitd, libgl1-mesa-dri, fonts-inter, fonts-font-awesome, fxload")
if(CMAKE_CROSSCOMPILING)
  # cpack's dpkg-shlibdeps looks among this machine's packages: tools/package asks it of the sysroot's.
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()
include(CPack)
