#!/usr/bin/env python
import rospy

def hello():
    rospy.init_node('hello', anonymous=True)
    rate = rospy.Rate(1)
    while not rospy.is_shutdown():
        rospy.loginfo("hello ros %s" % rospy.get_time())
        rate.sleep()

if __name__ == '__main__':
    try:
        hello()
    except rospy.ROSInterruptException:
        pass
