# What programs that link the libraries need of others; installed beside npdrConfig.cmake, too.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(SUNDIALS 6.4 REQUIRED COMPONENTS arkode cvode nvecserial)
find_package(PkgConfig REQUIRED)
# Bullet in double precision: in single, the velocity of a club at the end of a long arm is too coarse.
pkg_check_modules(BULLET REQUIRED IMPORTED_TARGET GLOBAL bullet-float64)
find_package(NLopt 2.7 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
