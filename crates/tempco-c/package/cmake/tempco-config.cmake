# find_package(tempco CONFIG) gives the imported target tempco::tempco.
#
# TEMPCO_TARGET names the archive, one of the folders in lib/. Where it is not set, it follows from
# the system and, on a Cortex-M, from the flags -mcpu and -mfloat-abi in CMAKE_C_FLAGS.

get_filename_component(_tempco_root "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)

if(NOT TEMPCO_TARGET)
    if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        set(TEMPCO_TARGET x86_64-unknown-linux-gnu)
    elseif(CMAKE_SYSTEM_NAME STREQUAL "Windows" AND NOT MSVC)
        set(TEMPCO_TARGET x86_64-pc-windows-gnu)
    elseif(CMAKE_C_FLAGS MATCHES "-mcpu=cortex-m0")
        set(TEMPCO_TARGET thumbv6m-none-eabi)
    elseif(CMAKE_C_FLAGS MATCHES "-mcpu=cortex-m3( |$)")
        set(TEMPCO_TARGET thumbv7m-none-eabi)
    elseif(CMAKE_C_FLAGS MATCHES "-mcpu=cortex-m[47]")
        if(CMAKE_C_FLAGS MATCHES "-mfloat-abi=hard")
            set(TEMPCO_TARGET thumbv7em-none-eabihf)
        else()
            set(TEMPCO_TARGET thumbv7em-none-eabi)
        endif()
    elseif(CMAKE_C_FLAGS MATCHES "-mcpu=cortex-m(33|35p|55)" AND CMAKE_C_FLAGS MATCHES "-mfloat-abi=hard")
        set(TEMPCO_TARGET thumbv8m.main-none-eabihf)
    endif()
endif()

set(_tempco_archive "${_tempco_root}/lib/${TEMPCO_TARGET}/libtempco.a")
if(NOT TEMPCO_TARGET OR NOT EXISTS "${_tempco_archive}")
    set(tempco_FOUND FALSE)
    set(tempco_NOT_FOUND_MESSAGE
        "no archive for this processor: set TEMPCO_TARGET to one of the folders in ${_tempco_root}/lib")
    return()
endif()

if(NOT TARGET tempco::tempco)
    add_library(tempco::tempco STATIC IMPORTED)
    set_target_properties(tempco::tempco PROPERTIES
        IMPORTED_LOCATION "${_tempco_archive}"
        INTERFACE_INCLUDE_DIRECTORIES "${_tempco_root}/include")
endif()
