# find_package(capsule): the targets capsule::capsule (both methods) and capsule::direct (without the paper's method).
get_filename_component(_capsule_root "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

foreach(_capsule_name IN ITEMS capsule direct)
  if(NOT TARGET capsule::${_capsule_name})
    add_library(capsule::${_capsule_name} STATIC IMPORTED)
    set_target_properties(capsule::${_capsule_name} PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES "${_capsule_root}/include")
    if(NOT APPLE)
      # The library's panic handler calls a function that exists nowhere: it must be left out.
      set_property(TARGET capsule::${_capsule_name} PROPERTY INTERFACE_LINK_OPTIONS "-Wl,--gc-sections")
    endif()
  endif()
endforeach()
set_target_properties(capsule::capsule PROPERTIES IMPORTED_LOCATION "${_capsule_root}/lib/libcapsule.a")
set_target_properties(capsule::direct PROPERTIES
  IMPORTED_LOCATION "${_capsule_root}/lib/libcapsule_direct.a"
  INTERFACE_COMPILE_DEFINITIONS CAPSULE_DIRECT)
unset(_capsule_root)
