# What is installed: libraries, headers, the CMake package and the pkg-config modules. The program installs itself.

include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/meniscus")
set(package_build_dir "${PROJECT_BINARY_DIR}/package")

# mns_install_library(TARGET NAME EXPORT): the library as meniscus::NAME, for find_package.
function(mns_install_library target name export)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT ${export}
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
  install(EXPORT ${export} NAMESPACE meniscus:: DESTINATION "${package_dir}")
endfunction()

# mns_install_module(NAME DESCRIPTION REQUIRES LIBS): NAME.pc, which finds its prefix from where it lies.
function(mns_install_module pc_name pc_description pc_requires pc_libs)
  set(pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
  set(pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
  if(IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
    set(pc_includedir "${CMAKE_INSTALL_INCLUDEDIR}")
  endif()
  if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
    set(pc_libdir "${CMAKE_INSTALL_LIBDIR}")
  endif()
  file(RELATIVE_PATH pc_prefix "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/meniscus.pc.in" "${package_build_dir}/${pc_name}.pc" @ONLY)
  install(FILES "${package_build_dir}/${pc_name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endfunction()

# Who links a static library links its libraries too; a shared one has them already. An installation has one kind, so that nobody
# has to ask pkg-config for --static.
set(MNS_STATIC ON)
set(libs " -pthread")
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  string(APPEND libs " -lm")
endif()
set(io_requires "")
set(MNS_IO_DEPENDENCIES "")
if(MNS_BUILD_IO)
  get_property(io_requires GLOBAL PROPERTY MNS_IO_REQUIRES)
  get_property(MNS_IO_DEPENDENCIES GLOBAL PROPERTY MNS_IO_DEPENDENCIES)
  list(JOIN MNS_IO_DEPENDENCIES "\n    " MNS_IO_DEPENDENCIES)
endif()
if(BUILD_SHARED_LIBS)
  set(MNS_STATIC OFF)
  set(libs "")
  set(io_requires "")
endif()

mns_install_library(meniscus meniscus meniscus-targets)
mns_install_module(meniscus "${PROJECT_DESCRIPTION}" "" "-lmeniscus${libs}")
set(unbuilt_headers "")
if(MNS_BUILD_IO)
  mns_install_library(meniscus_io io meniscus-io-targets)
  list(JOIN io_requires " " io_requires)
  mns_install_module(meniscus-io "Particle and image files for meniscus" "meniscus = ${PROJECT_VERSION} ${io_requires}" "-lmeniscus_io")
else()
  list(APPEND unbuilt_headers PATTERN io.h EXCLUDE)
endif()
set(MNS_SCENE_DEPENDENCIES "")
if(MNS_BUILD_SCENE)
  mns_install_library(meniscus_scene scene meniscus-scene-targets)
  set(scene_requires "")
  set(scene_libs "")
  if(MNS_HAVE_MESHES AND NOT BUILD_SHARED_LIBS)
    set(MNS_SCENE_DEPENDENCIES
      "meniscus_find_module(MNS_ASSIMP assimp)\n    meniscus_find_module(MNS_STB stb)\n    find_dependency(embree 3)")
    set(scene_requires " assimp stb")
    if(MNS_SCENE_EXR_FOUND)
      string(APPEND MNS_SCENE_DEPENDENCIES "\n    find_dependency(OpenEXR CONFIG)")
      string(APPEND scene_requires " OpenEXR")
    endif()
    set(scene_libs " -lembree3")
  endif()
  mns_install_module(meniscus-scene "Opaque meshes around meniscus' fluids" "meniscus = ${PROJECT_VERSION}${scene_requires}"
    "-lmeniscus_scene${scene_libs}")
else()
  list(APPEND unbuilt_headers PATTERN scene.h EXCLUDE)
endif()

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/meniscus" "${PROJECT_BINARY_DIR}/include/meniscus"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h" ${unbuilt_headers})

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/meniscus-config.cmake.in" "${package_build_dir}/meniscus-config.cmake"
  INSTALL_DESTINATION "${package_dir}")
if(PROJECT_VERSION_MAJOR EQUAL 0) # as the soname does
  set(compatibility SameMinorVersion)
else()
  set(compatibility SameMajorVersion)
endif()
write_basic_package_version_file("${package_build_dir}/meniscus-config-version.cmake" COMPATIBILITY ${compatibility})
install(FILES "${package_build_dir}/meniscus-config.cmake" "${package_build_dir}/meniscus-config-version.cmake" DESTINATION "${package_dir}")

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/THIRD-PARTY.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(EXISTS "${PROJECT_SOURCE_DIR}/docs/meniscus.1")
  install(FILES "${PROJECT_SOURCE_DIR}/docs/meniscus.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
endif()
