# A rollout of a pendulum of 1 kg and 1 m that is pushed, as CSV: awk -v push=4.5 -f record.awk
BEGIN {
  dt = 0.02
  print "t [s],theta [rad],theta_dot [rad/s],torque [N m]"
  for (i = 0; i <= 400; ++i) {
    torque = push * sin(0.01 * i)
    printf "%.2f,%.9f,%.9f,%.9f\n", dt * i, angle, rate, torque
    acceleration = torque - 9.81 * sin(angle)
    angle += dt * (rate + 0.5 * dt * acceleration)
    rate += 0.5 * dt * (acceleration + torque - 9.81 * sin(angle))
  }
}
