#include "rclcpp/rclcpp.hpp"

int main(int argc, char **argv)
{
    rclcpp::init(argc, argv);
    auto node = std::make_shared<rclcpp::Node>("hello");
    RCLCPP_INFO(node->get_logger(), "hello");
    rclcpp::spin(node);
    return 0;
}
