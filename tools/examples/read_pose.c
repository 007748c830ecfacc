/* Prints every pose of a SLAM sensor, from LCM. In a folder with it and
 * firmware/lcm/types/slamsensor_pose_t.lcm, with gcc, liblcm-bin, liblcm-dev, libglib2.0-dev and pkgconf from
 * Debian:
 *
 *   lcm-gen --c slamsensor_pose_t.lcm
 *   gcc -I. read_pose.c slamsensor_pose_t.c -o read_pose $(pkg-config --cflags --libs lcm) -lm
 *
 * A line per pose: seconds since 1970, status, x (m), y (m), heading (degrees, counter-clockwise from the
 * map's x axis), number of the map, protection radius (m); those only where there is a fix, or the better of
 * two places. */
#include "slamsensor_pose_t.h"

#include <lcm/lcm.h>
#include <math.h>
#include <stdio.h>

static void on_pose(const lcm_recv_buf_t* buffer, const char* channel, const slamsensor_pose_t* pose,
                    void* user) {
  static const char* const kStatus[] = {"no_fix", "ambiguous", "fix"};
  (void)buffer;
  (void)channel;
  (void)user;
  if (pose->status < SLAMSENSOR_POSE_T_STATUS_NO_FIX || pose->status > SLAMSENSOR_POSE_T_STATUS_FIX) {
    return;
  }
  printf("%.2f %s", (double)pose->utime * 1e-6, kStatus[pose->status]);
  if (pose->status != SLAMSENSOR_POSE_T_STATUS_NO_FIX) {
    double heading_deg = pose->heading_rad * 180.0 / M_PI;
    printf(" %.3f %.3f %.2f", pose->x_m, pose->y_m, heading_deg < 0.0 ? heading_deg + 360.0 : heading_deg);
    printf(" %lld %.2f", (long long)pose->map, pose->protection_radius_m);
  }
  printf("\n");
  fflush(stdout);
}

int main(void) {
  lcm_t* lcm = lcm_create(NULL); /* LCM_DEFAULT_URL, else the default group */
  slamsensor_pose_t_subscription_t* subscription;
  if (lcm == NULL) {
    fprintf(stderr, "LCM does not start: is there a route for multicast?\n");
    return 1;
  }
  subscription = slamsensor_pose_t_subscribe(lcm, "SLAMSENSOR_POSE", on_pose, NULL);
  slamsensor_pose_t_subscription_set_queue_capacity(subscription, 1000);
  while (lcm_handle(lcm) == 0) {
  }
  lcm_destroy(lcm);
  return 1;
}
