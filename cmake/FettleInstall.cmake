# What `cmake --install` places where a Linux desktop looks for it, after the targets reference and icons were built.
# scripts/package makes a Debian package of it.
include(GNUInstallDirs)

# Man pages and completions are made by the program itself, of the tables it reads its arguments by.
set(FETTLE_REFERENCE ${CMAKE_BINARY_DIR}/reference)
add_custom_command(OUTPUT ${FETTLE_REFERENCE}/parameters.json
  COMMAND fettle reference ${FETTLE_REFERENCE} --quiet DEPENDS fettle VERBATIM)
add_custom_target(reference DEPENDS ${FETTLE_REFERENCE}/parameters.json)

# Icons in the sizes that menus and task bars ask for; a drawing serves all others.
set(FETTLE_ICONS)
find_program(RSVG_CONVERT rsvg-convert)
if(RSVG_CONVERT)
  foreach(size 16 22 24 32 48 64 128 256 512)
    set(icon ${CMAKE_BINARY_DIR}/icons/hicolor/${size}x${size}/apps/fettle.png)
    add_custom_command(OUTPUT ${icon}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/icons/hicolor/${size}x${size}/apps
      COMMAND ${RSVG_CONVERT} -w ${size} -h ${size} ${CMAKE_SOURCE_DIR}/assets/desktop/fettle.svg -o ${icon}
      DEPENDS ${CMAKE_SOURCE_DIR}/assets/desktop/fettle.svg VERBATIM)
    list(APPEND FETTLE_ICONS ${icon})
  endforeach()
endif()
add_custom_target(icons DEPENDS ${FETTLE_ICONS})

# The date of the newest release.
file(STRINGS ${CMAKE_SOURCE_DIR}/CHANGELOG.md FETTLE_RELEASED REGEX "^## \\[[0-9.]+\\] - ")
list(GET FETTLE_RELEASED 0 FETTLE_RELEASED)
string(REGEX REPLACE ".* - " "" FETTLE_RELEASED ${FETTLE_RELEASED})
set(FETTLE_METAINFO io.github.fettle.fettle.metainfo.xml)
configure_file(assets/desktop/${FETTLE_METAINFO}.in ${CMAKE_BINARY_DIR}/${FETTLE_METAINFO} @ONLY)

install(TARGETS fettle RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# The Python package, where Debian's interpreter looks. A component of its own: a package of its own.
if(FETTLE_PYTHON_MODULE)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/python/fettle DESTINATION lib/python3/dist-packages COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed" PATTERN "_fettle.*.so" PATTERN "__pycache__" EXCLUDE)
endif()
install(DIRECTORY ${FETTLE_REFERENCE}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${FETTLE_REFERENCE}/completion/fettle.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME fettle)
install(FILES ${FETTLE_REFERENCE}/completion/_fettle DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${FETTLE_REFERENCE}/completion/fettle.fish
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(DIRECTORY assets/scenes assets/devices DESTINATION ${CMAKE_INSTALL_DATADIR}/fettle)
# Translations of the window, where gettext is installed.
find_program(MSGFMT msgfmt)
file(GLOB FETTLE_TRANSLATIONS CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/assets/texts/*.po)
if(MSGFMT AND FETTLE_TRANSLATIONS)
  set(FETTLE_CATALOGUES)
  foreach(translation ${FETTLE_TRANSLATIONS})
    get_filename_component(language ${translation} NAME_WE)
    set(catalogue ${CMAKE_BINARY_DIR}/texts/${language}.mo)
    add_custom_command(OUTPUT ${catalogue}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/texts
      COMMAND ${MSGFMT} --endianness=little -o ${catalogue} ${translation} DEPENDS ${translation} VERBATIM)
    list(APPEND FETTLE_CATALOGUES ${catalogue})
  endforeach()
  add_custom_target(catalogues ALL DEPENDS ${FETTLE_CATALOGUES})
  install(FILES ${FETTLE_CATALOGUES} DESTINATION ${CMAKE_INSTALL_DATADIR}/fettle/texts)
endif()
install(FILES assets/udev/70-fettle.rules DESTINATION lib/udev/rules.d)
install(FILES assets/desktop/io.github.fettle.fettle.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES assets/desktop/fettle-mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME fettle.xml)
install(FILES ${CMAKE_BINARY_DIR}/${FETTLE_METAINFO} DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo)
install(FILES assets/desktop/fettle.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
install(DIRECTORY ${CMAKE_BINARY_DIR}/icons/hicolor DESTINATION ${CMAKE_INSTALL_DATADIR}/icons OPTIONAL)
