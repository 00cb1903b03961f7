"""照着 ROS 1 的教程写：Humble 里没有 rospy。"""

import rospy

rospy.init_node('greeter')
rospy.loginfo('大家好，我启动了！')
rospy.spin()
